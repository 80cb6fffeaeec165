"""Joint states from a URDF: joints are where parameters put them, or where other publishers of joint states do."""
