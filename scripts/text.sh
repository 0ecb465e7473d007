#!/bin/sh
# Everything of docs/benchmarks/text-editing.md: data, networks, the baseline, and what is measured. An
# interrupted step resumes. Words after the first go to `train`: --accelerator gpu.
#
#     scripts/text.sh .venv/bin/garmentimage
#     SHORT=yes scripts/text.sh .venv/bin/garmentimage    # 40 to 75 minutes of training, no baseline
set -eu
run=$1
shift
export OMP_NUM_THREADS=1
data=data/text-edit
if [ "${SHORT-}" ]; then
    runs=runs/text-short measured=runs/edits-short denoiser=20 vae=30 pictures=14
    vectors= garments=12
    set -- --batch 16 --rate 0.001 "$@" # about as many steps as the long ones, in fewer epochs
else
    runs=runs/text measured=runs/edits denoiser=100 vae=80 pictures=60
    vectors=yes garments=24
fi

train() { # name, network, epochs, further words
    name=$1 network=$2 epochs=$3
    shift 3
    "$run" train "$network" --data $data --epochs "$epochs" "$@" -o "$runs-$name"
}

"$run" build text-edit --count 1500 -o $data
train denoiser denoiser $denoiser "$@" & # beside the two that need each other
train vae vae $vae "$@"
train pictures image-decoder $pictures --vae $runs-vae/model "$@"
wait $!
if [ $vectors ]; then
    train vector-vae vector-vae 80 "$@"
    train vector-pictures image-decoder 24 --vae $runs-vector-vae/model "$@"
    vectors="--vectors $runs-vector-vae/model --vector-image-decoder $runs-vector-pictures/model"
fi
"$run" evaluate text --data $data --space $runs-vae/model --image-decoder $runs-pictures/model \
    --denoiser $runs-denoiser/model $vectors --garments $garments -o $measured
