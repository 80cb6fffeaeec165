"""How nodes call one another: goals of the action `servo`, and services."""
