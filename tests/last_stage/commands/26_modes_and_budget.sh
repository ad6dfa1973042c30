# What stands in the reference of commands, at a pose.
flexapod new robot.toml --preset machine-hexapod > /dev/null; echo new $?
flexapod modes robot.toml --pose "roll=5deg,heave=10mm" --count 3 --json > modes.json; echo modes $?
flexapod budget robot.toml --out budget --no-figures --quiet --json > budget.json; echo budget $?
flexapod damp robot.toml --count 4 --json > damp.json; echo damp $?
