# From nothing to the answer for one machine, as the page "Start" has it.
flexapod new robot.toml --from "home=900 mm, payload=150 kg, stroke=200 mm" > /dev/null; echo new $?
flexapod new paper.toml --preset paper-robot > /dev/null; echo preset $?
flexapod new paper.toml --preset paper-robot > /dev/null 2>&1; echo again $?
flexapod check robot.toml --json > check.json; echo check $?
flexapod run paper.toml --no-figures --json > run.json; echo run $?
flexapod run paper.toml --no-figures --quiet | grep -c "misses its rigid path by up to"; echo grep $?
head -1 paper-run/results.csv | tr ',' '\n' | head -4
