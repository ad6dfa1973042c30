# Files for other programs, a figure of a run, an example of the gallery, a case with a known answer.
flexapod new paper.toml --preset paper-robot > /dev/null; echo new $?
flexapod export paper.toml --format abaqus --count 6 --pose "heave=20mm" --out raised.inp > /dev/null; echo abaqus $?
flexapod export paper.toml --format mat --inputs wrench,floor:z --outputs tool,stroke --json > mat.json; echo mat $?
flexapod export paper.toml --format mjcf --out paper.xml > /dev/null; echo mjcf $?
flexapod export paper.toml --format c --step 0.5ms --commands motion --out steps > /dev/null; echo c $?
flexapod export paper.toml --format abaqus --out raised.inp > /dev/null 2>&1; echo there $?
flexapod new --example sag_by_hand > /dev/null; echo example $?
flexapod verify --only cantilever --json > verify.json 2> verify.txt; echo verify $?
