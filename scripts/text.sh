#!/bin/sh
# Everything of docs/text.md: data, networks, the baseline, and what is measured. Each step goes on
# where it was stopped. Words after the first go to `train`: --accelerator gpu.
#
#     scripts/text.sh .venv/bin/garmentimage
set -eu
run=$1
shift
export OMP_NUM_THREADS=1
data=data/text-edit

train() { # name, network, epochs, further words
    name=$1 network=$2 epochs=$3
    shift 3
    "$run" train "$network" --data $data --epochs "$epochs" "$@" -o "runs/text-$name"
}

"$run" build text-edit --count 1500 -o $data
train denoiser denoiser 100 "$@" & # beside the two that need each other
train vae vae 80 "$@"
train pictures image-decoder 60 --vae runs/text-vae/model "$@"
wait $!
train vector-vae vector-vae 80 "$@"
train vector-pictures image-decoder 24 --vae runs/text-vector-vae/model "$@"
"$run" evaluate edit --data $data --space runs/text-vae/model --pictures runs/text-pictures/model \
    --denoiser runs/text-denoiser/model --vectors runs/text-vector-vae/model \
    --vector-pictures runs/text-vector-pictures/model -o runs/edits
