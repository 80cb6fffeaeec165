# Debian 12 with the packages of this workspace; `--build-arg RELEASE=13` is Debian 13:
#   docker build -t aras-visual-servo .
#   docker run --rm -v "$PWD/results:/workspace/results" aras-visual-servo run experiment_1
# The stage `packages` has everything that building and testing needs, and no workspace: the development container.
ARG RELEASE=12
FROM debian:${RELEASE} AS packages
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git sudo
WORKDIR /packages
COPY script/packages.txt script/environment.sh script/bootstrap script/
RUN script/bootstrap --test --gazebo --package --packages

FROM packages AS build
WORKDIR /clone
COPY . .
RUN script/package /deb

FROM debian:${RELEASE}
COPY --from=build /deb/*.deb /deb/
RUN apt-get update && apt-get install -y --no-install-recommends /deb/*.deb ffmpeg && rm -r /deb /var/lib/apt/lists/*
WORKDIR /workspace
ENTRYPOINT ["aras-servo"]
CMD ["run", "experiment_1"]
