"""The program gzclient: rviz in place of Gazebo's window. Without rviz or a display it stays, because launch files end
as a whole when a required node ends."""
import os
import shutil
import signal
import sys
import typing

import rospkg
import rospy

ENDS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}  #: signals that end it


def viewer() -> typing.Tuple[typing.Optional[str], str]:
    """Returns the path of rviz and "", or None and why there is no window."""
    path = shutil.which("rviz")
    if not path:
        return None, "there is no rviz, `script/bootstrap --view` installs it"
    return (path, "") if os.environ.get("DISPLAY") else (None, "DISPLAY is not set")


def main() -> int:
    """Becomes rviz, or waits for a signal. Returns 0 after the signal."""
    path, reason = viewer()
    if path is None:
        signal.pthread_sigmask(signal.SIG_BLOCK, ENDS)
        print("gzclient: no window: %s; the simulation goes on without (gui:=false says nothing)" %
              reason, flush=True)
        signal.sigwait(ENDS)
        return 0
    config = rospkg.RosPack().get_path("aras_visual_servo_sim") + "/config/sim.rviz"
    arguments = [each for each in sys.argv[1:] if each != "--verbose" and each not in rospy.myargv()[1:]]
    os.execv(path, [path, "-d", config, *arguments])
