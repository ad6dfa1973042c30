"""A study before it is computed: `robot.describe`."""
