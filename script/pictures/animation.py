"""The animated pictures of README.md: camera image, arm and error curves of a run, frame by frame as in its video."""
import cv2
import numpy as np
import PIL.Image

from aras_visual_servo_study.report.video import HOLD_S, Composer
import aras_visual_servo as avs
from aras_visual_servo import load_scenario

WIDTH, RATE_HZ, SPEED = 800, 10, 0.5
#: Of WebP, 0 to 100: below 90 grey levels show the blocks of the encoder. Lossless files are seven times as large.
QUALITY = 90
SCENARIOS = ("experiment_1", "six_dof_photometric")


def animate(name, path):
    """Runs a scenario and writes it as an animated WebP picture, at SPEED times its speed.

    Args: path: of the .webp to write.
    Raises: VideoError: the arm cannot be shown.
    """
    record = avs.run(load_scenario(name), keep_images=True)
    composer, t_s = Composer(record, list(record.servo_rows)), record.servo_t_s
    step_s = SPEED / RATE_HZ
    chosen = [int(np.abs(t_s - t).argmin()) for t in np.arange(0.0, t_s[-1] + 0.5 * step_s, step_s)]
    frames = [composer.frame(index) for index in chosen]
    height = round(WIDTH * frames[0].shape[0] / frames[0].shape[1])
    first, *others = (PIL.Image.fromarray(cv2.resize(frame, (WIDTH, height), interpolation=cv2.INTER_AREA))
                      for frame in frames)
    shown_ms = [1000 // RATE_HZ] * len(others) + [round(1000 * HOLD_S / SPEED)]
    first.save(path, "WEBP", save_all=True, append_images=others, duration=shown_ms, loop=0, quality=QUALITY, method=4)
