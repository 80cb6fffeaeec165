# Debian 12 with this workspace, built; `--build-arg RELEASE=13` is Debian 13:
#   docker build -t aras-visual-servo .
#   docker run --rm -v "$PWD/results:/workspace/results" aras-visual-servo run experiment_1
# The stage `packages` has everything that building and testing needs, and no workspace: the development container.
ARG RELEASE=12
FROM debian:${RELEASE} AS packages
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git sudo
WORKDIR /packages
COPY script/packages.txt script/environment.sh script/bootstrap script/
RUN script/bootstrap --test --gazebo --packages

FROM packages AS workspace
WORKDIR /workspace
COPY . .
RUN script/bootstrap
ENTRYPOINT ["/bin/bash", "-c", ". install/setup.sh && exec rosrun aras_visual_servo_controller \"$@\"", "rosrun"]
CMD ["run", "experiment_1"]
