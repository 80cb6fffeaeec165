"""Visual servoing without ROS: features, laws, servo, scenarios and runs."""
