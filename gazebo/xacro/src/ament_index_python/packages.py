"""Folders of packages, as ROS 1 finds them."""
import rospkg


def get_package_share_directory(name: str) -> str:
    """Folder of a package. Raises: rospkg.ResourceNotFound, which names the package and where it was looked for."""
    return rospkg.RosPack().get_path(name)
