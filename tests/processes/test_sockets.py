"""What a run over ROS listens on: the loopback, as far as ROS allows."""
import subprocess

import psutil
from ros_graph import LIMIT_S, until

#: roscpp binds its XML-RPC server to every interface whatever ROS_HOSTNAME says: one port of each of these.
ROSCPP = {"rosout", "sim_node"}
ALL = ROSCPP | {"roslaunch", "rosmaster", "controller", "experiment"}


def listening(process):
    """process name -> addresses at which sockets of processes of that name wait for others, TCP and UDP."""
    found = {}
    for one in process.children(recursive=True):
        try:
            addresses = [link.laddr.ip for link in one.connections("inet")
                         if link.status == psutil.CONN_LISTEN or (link.status == psutil.CONN_NONE and not link.raddr)]
            found[one.name()] = sorted([*found.get(one.name(), []), *addresses])
        except psutil.NoSuchProcess:
            pass
    return found


def test_a_run_listens_on_the_loopback_only_as_far_as_ros_allows(slow_scenario, own_master, tmp_path):
    run = subprocess.Popen(["rosrun", "aras_visual_servo_controller", "run", str(slow_scenario), "--output",
                            str(tmp_path)], env=own_master)
    seen = {}

    def all_seen():
        assert run.poll() is None, "it ended before everything was seen"
        for name, addresses in listening(psutil.Process(run.pid)).items():
            seen[name] = max(seen.get(name, []), addresses, key=len)
        return ALL <= set(seen) and all(seen[name] for name in ALL)

    try:
        until(all_seen, "every process listens")
    finally:
        run.terminate()
        run.wait(LIMIT_S)
    for name, addresses in seen.items():
        open_to_all = [address for address in addresses if not address.startswith("127.")]
        assert len(open_to_all) == (1 if name in ROSCPP else 0), (name, addresses)
