"""The animated pictures of README.md: camera image, arm and error curves of a run, from its own video."""
import pathlib
import subprocess
import tempfile

from aras_visual_servo_study.report.video import save_video
import aras_visual_servo as avs
from aras_visual_servo import load_scenario

WIDTH, RATE_HZ = 800, 10
#: Of WebP, 0 to 100: below 60 the curves get smudged.
QUALITY = 60
SCENARIOS = ("experiment_1", "six_dof_photometric")


def animate(name, path):
    """Run a scenario and write it as an animated WebP picture, at half its speed.

    Args: path: of the .webp to write.
    Raises: subprocess.CalledProcessError: ffmpeg failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        film = save_video(avs.run(load_scenario(name), keep_images=True), pathlib.Path(folder) / "video.mp4")
        subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", "-i", str(film.path), "-vf",
                        f"setpts=2*PTS,fps={RATE_HZ},scale={WIDTH}:-1:flags=area", "-c:v", "libwebp_anim", "-loop", "0",
                        "-quality", str(QUALITY), "-map_metadata", "-1", "-f", "webp", str(path)], check=True)
