"""How settings are read and checked, and where files are found."""
