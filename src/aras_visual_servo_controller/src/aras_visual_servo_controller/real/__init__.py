"""What a real arm needs beyond the simulator: joints at the time of an image, latency, limits, stops."""
