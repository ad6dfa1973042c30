# A map and a sweep, which continues where it was.
flexapod map studies/files/hexaglide-text.toml --x surge=-50..50mm:3 --y heave --count 3 --at roll=1deg --direction 1,0,1 --out map --no-figures --quiet --json > map.json; echo map $?
flexapod sweep studies/files/tripod-numbers.toml studies/files/sweep-masses.toml --workers 0 --no-figures --quiet --json --out swept > sweep.json; echo sweep $?
flexapod sweep studies/files/tripod-numbers.toml studies/files/sweep-masses.toml --workers 0 --no-figures --quiet --out swept > again.txt; echo again $?
head -1 swept/sweep.csv
flexapod keys leg.drive | grep -c stiffness
