"""What xacro asks for the folders of packages."""
