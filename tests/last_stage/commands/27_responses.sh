# Responses between named channels, for other programs.
flexapod new nano.toml --preset nano-hexapod > /dev/null; echo new $?
flexapod frf nano.toml --input wrench:fz,floor:z --output tool:z --from 5Hz --to 500Hz --points 5 --out response --no-figures --json > frf.json; echo frf $?
flexapod frf nano.toml --input wrench:fz --output tool:z --from "20 Hz" --to "200 Hz" --points 4 --uff nano.uff --mat nano.mat --no-figures > /dev/null; echo uff $?
grep -c "^    58" nano.uff
flexapod damp nano.toml --count 6 --json > damp.json; echo damp $?
flexapod frf nano.toml --input wrench:fq --output tool:z --json > none.txt 2> refused.json; echo refused $?
