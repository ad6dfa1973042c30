# Exit codes, and errors as JSON with the key that is meant.
flexapod new robot.toml --preset machine-hexapod > /dev/null; echo new $?
sed 's/lead = "10 mm"/lead = "10 kg"/' robot.toml > unit.toml
sed 's/lead = "10 mm"/leed = "10 mm"/' robot.toml > key.toml
sed 's/^mass = "250 kg"/mass = "-250 kg"/' robot.toml > mass.toml
flexapod check unit.toml --json > out.txt 2> unit.json; echo unit $?
flexapod check key.toml --json > out.txt 2> key.json; echo key $?
flexapod check mass.toml --json > out.txt 2> mass.json; echo mass $?
flexapod run none.toml --json > out.txt 2> none.json; echo none $?
flexapod modes robot.toml --pose "rol=5deg" --json > out.txt 2> pose.json; echo pose $?
flexapod export robot.toml --format step --json > out.txt 2> format.json; echo format $?
flexapod chek robot.toml > out.txt 2>&1; echo command $?
flexapod check unit.toml 2>&1 | grep -c "leg.drive.lead"
