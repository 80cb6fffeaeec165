"""What a browser needs to draw a run: the robot's links and meshes, the scene, and the files of the page."""
