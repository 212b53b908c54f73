#!/usr/bin/env bash
# Minutes on a machine with a GPU: goes on from the last checkpoint, stops by itself in time, leaves checkpoint and curves.
#
#   training/sprint.sh SIMPLIFIED RAW OUT [SECONDS_NOW] [SECONDS_IN_ALL]
#
# SIMPLIFIED, RAW: Quick, Draw! ndjson. OUT: holds checkpoint.pt (to go on from), weights.pt (small, for --start and for
# export), curves.png, history.json. The learning rate falls towards the end of SECONDS_IN_ALL, over as many calls as it
# takes. Without a checkpoint in OUT the weights that the repository holds are gone on from. Needs the training extra.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 3 ] || { sed -n '2,8s/^# \?//p' "$0"; exit 2; }
simplified=$1 raw=$2 out=$3 now=${4:-540} all=${5:-1620}
python=${PYTHON:-python3}

if [ -f "$out/checkpoint.pt" ]; then from=(--resume); else from=(--start training/weights.pt); fi
"$python" -m training.train --data "$simplified" --raw "$raw" --out "$out" "${from[@]}" \
    --seconds "$all" --stop-after-s "$((now - 45))" --save-every-s 120 \
    --batch 64 --workers "$(($(nproc) > 3 ? $(nproc) - 2 : 1))" \
    --optimiser muon --learning-rate 0.02 --weight-decay 0.01 --warm-up 0.02 --fall 0.5 --ema 0.99
"$python" -c 'import sys; from pathlib import Path; from training.export import save_weights
save_weights(Path(sys.argv[1], "weights.pt"), Path(sys.argv[1], "checkpoint.pt"))' "$out"
ls -l "$out"
