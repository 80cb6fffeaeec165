"""Calls of ros_control's controller manager; the programs spawner, unspawner and controller_manager use them."""
