"""Bags as a rosbag2: a folder with metadata.yaml and an MCAP file, in which all messages have ROS 2 types."""

from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Union

from aras_visual_servo import extra

#: Version of rosbag2's metadata that rosbags writes; ROS 2 reads it since Iron.
VERSION = 9


def write_rosbag2(path: Path, sources: Iterable[Union[str, Path]]) -> int:
    """Writes every message of these bags into a new folder. Returns their number.

    Messages whose type is the same in ROS 2 pass as bytes; only `seq` of headers has no place there. The fields of
    others, such as visualization_msgs/Marker, are taken over by name.
    Raises: MissingExtra: there is no rosbags.  BagError: a bag cannot be read.  WireError: a message type of the bag is
        not installed.  OSError: the folder exists, or cannot be written.
    """
    from aras_visual_servo_controller import BagFiles
    library, types = (extra(f"rosbags.{name}", "writing a ROS 2 bag") for name in ("rosbag2", "typesys"))
    store = types.get_typestore(types.Stores.ROS2_KILTED)
    known: Dict[str, Any] = {}  # topic -> (connection, converter)
    count = 0
    writer = library.Writer(path, version=VERSION, storage_plugin=library.StoragePlugin.MCAP)
    writer.set_compression(library.CompressionMode.STORAGE, library.CompressionFormat.ZSTD)
    with writer:
        for source in sources:
            with BagFiles(source) as bags:
                for topic, (kind, data, _, _, python), time in bags.raw_messages():
                    if topic not in known:
                        convert = _converter(store, python)
                        connection = writer.add_connection(topic, kind.replace("/", "/msg/"), typestore=store)
                        known[topic] = connection, convert
                    connection, convert = known[topic]
                    writer.write(connection, time.to_nsec(), convert(data))
                    count += 1
    return count


def _converter(store: Any, python: Any) -> Callable[[bytes], bytes]:
    """Returns the function from ROS 1 bytes to CDR of a message class. The store gets the types that it lacks."""
    from aras_visual_servo_controller import definitions_of, to_cdr
    types = extra("rosbags.typesys", "writing a ROS 2 bag")
    ours = {}
    for name, text in definitions_of(python).items():
        ours.update(types.get_types_from_msg(text, name))
    store.register({name: fields for name, fields in ours.items() if name not in store.fielddefs})
    if all(store.fielddefs[name][1] == fields[1] for name, fields in ours.items()):
        as_bytes = to_cdr(python)
        return lambda data: as_bytes(data, 0)
    name = python._type.replace("/", "/msg/")
    of_ros1 = types.get_typestore(types.Stores.EMPTY)
    of_ros1.register(types.get_types_from_msg(python._full_text, name))
    migrate, cache = extra("rosbags.convert.converter", "writing a ROS 2 bag").migrate_bytes, {}
    return lambda data: migrate(of_ros1, store, name, name, cache, data, src_is2=False, dst_is2=True)
