"""Settings of a real arm: section `real` of a scenario, and the command forms that it names."""
