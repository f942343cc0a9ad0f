#!/bin/sh
# The closed loop from the shell, on files that the commands write and nothing else, for one member:
#
#     loop.sh FOLDER [SET [MEMBER [SHOP]]]
#
# A tip that nobody knows is calibrated; the member is cut, milled, probed and judged, its settings are corrected, and it
# is cut, milled, probed and judged again. Fails where a command does, and where flanks or pitch have not become better:
# a hobbed member has no index that could be corrected, and its pitch must stay as good as it was.
# GEARMATH is the command to run.
set -eu
folder=$1 set=${2:-nasa_tp3096_12x36.toml} member=${3:-pinion} shop=${4:-simulated_shop.toml}
gearmath=${GEARMATH:-gearmath}
cd "$folder"

# the probe as it really is, and as its file says: tip 7 um smaller, 55 um off the spindle axis
cat > believed.toml <<PROBE
name = "Touch probe of the loop"
length = 200.0
tip_radius = 0.75
stylus_radius = 0.5
stylus_length = 30.0

[sphere]
center = [-250.0, 150.0, 400.0]
diameter = 20.0
PROBE
sed 's/^tip_radius = .*/tip_radius = 0.743/; s/^stylus_radius/offset = [0.031, -0.045, 0.012]\n&/' believed.toml > true.toml

"$gearmath" nc calibrate --calibration believed.toml -o CALIBRATE.MPF
"$gearmath" probe CALIBRATE.MPF --calibration true.toml --errors "$shop" -o calibration.csv
"$gearmath" calibrate calibration.csv --calibration believed.toml -o found.toml

"$gearmath" nc probe "$set" --member "$member" --calibration found.toml -o PROBE.MPF

# cut_and_measure NUMBER SETTINGS: the part of this number, cut by these settings, judged in evaluated_NUMBER.json
cut_and_measure() {
    "$gearmath" nc cut "$2" --member "$member" --tolerance-um 2 -o "CUT_$1.MPF"
    "$gearmath" mill "$2" --member "$member" --program "CUT_$1.MPF" --errors "$shop" -o "metal_$1.csv"
    "$gearmath" probe PROBE.MPF --set "$set" --member "$member" --calibration true.toml --errors "$shop" \
        --measured "metal_$1.csv" --run "$1" -o "raw_$1.csv"
    "$gearmath" touches "raw_$1.csv" --set "$set" --calibration found.toml -o "measured_$1.csv"
    "$gearmath" evaluate "measured_$1.csv" --set "$set" --json > "evaluated_$1.json"
}

cut_and_measure 1 "$set"
"$gearmath" compensate "$set" --member "$member" --measured measured_1.csv -o corrected.toml
cut_and_measure 2 corrected.toml

# worst KEY NUMBER: the largest value in size that a key has in a part's evaluation, flank by flank
worst() {
    awk -F: -v key="\"$1\"" '{ name = $1; gsub(/[ \t]/, "", name) }
        name == key { value = $2 + 0; if (value < 0) value = -value; if (value > most) most = value; found = 1 }
        END { if (!found) exit 1; print most }' "evaluated_$2.json"
}

for key in rms_um max_deviation_um F_p_um; do
    before=$(worst "$key" 1) after=$(worst "$key" 2)
    echo "$key: $before -> $after"
    most=0.5
    if [ "$key" = F_p_um ] && grep -A 5 "^\[$member\]" corrected.toml | grep -q face_hobbing; then most=1.1; fi
    awk "BEGIN { exit !($after < $most * $before) }" || { echo "$key is not below $most of what it was" >&2; exit 1; }
done
