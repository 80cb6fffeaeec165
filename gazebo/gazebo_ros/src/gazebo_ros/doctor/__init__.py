"""Says before a start what a package asks for that is not there."""
