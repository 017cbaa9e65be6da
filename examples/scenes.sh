#!/bin/sh
# SPDX-License-Identifier: MIT
# Scenes of the lessons that are not about ch2, out of Debian's packages: scenes.sh FOLDER. With
# IFTTY_SCENES=/usr/share/mricron/templates:FOLDER iftty finds them.
set -eu
folder=$1
doc=/usr/share/doc
skull=$doc/invesalius-examples/examples/Cranium.inv3
subject=$doc/insighttoolkit5-examples/examples/Data/KmeansTest_T1
for file in "$skull" "${subject}UCharRaw.nii.gz" "${subject}RawSkullStrip.nii.gz"; do
    [ -f "$file" ] || {
        echo "scenes.sh: there is no $file here;" \
            "apt-get install invesalius-examples insighttoolkit5-examples" >&2
        exit 1
    }
done
mkdir -p "$folder"
tar -xzOf "$skull" --wildcards '*/matrix.dat' >"$folder/skull.raw"
cp "${subject}UCharRaw.nii.gz" "$folder/subject.nii.gz"
cp "${subject}RawSkullStrip.nii.gz" "$folder/subject-brain.nii.gz"
