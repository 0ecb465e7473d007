#!/bin/sh
# Everything of docs/benchmarks/prediction.md: data, networks, and what is measured. An
# interrupted step resumes; two recipes, or two seeds, may be run beside each other.
#
#     scripts/image.sh .venv/bin/garmentimage
set -eu
run=$1
export OMP_NUM_THREADS=1

whole="--ablate recombine --ablate recolour" # garments as they are

train() { # name, network, epochs, further words
    name=$1 network=$2 epochs=$3
    shift 3
    "$run" train "$network" --data "data/$recipe" --epochs "$epochs" "$@" \
        -o "runs/$recipe-$name"
}

epochs=40
for recipe in d2 d1; do
    "$run" build "$recipe" --count 7000 --unseen 1000 -o "data/$recipe"
    train cascade-0 cascade $epochs
    train whole-0 cascade 24 $whole
    if [ "$recipe" = d2 ]; then # further seeds, baselines, ablations with a third of the training
        for seed in 1 2; do
            train "cascade-$seed" cascade $epochs --seed "$seed"
            train "whole-$seed" cascade 24 --seed "$seed" $whole
        done
        train panel-transformer panel-transformer 8 --rate 0.0005 --batch 32
        train panel-recurrent panel-recurrent 18 --rate 0.004
        train panel-pool panel-pool 30
        train short cascade 8
        for part in recombine recolour shares; do
            train "short-without-$part" cascade 8 --ablate "$part"
        done
        train short-whole cascade 8 $whole
        for part in losses noise weights mirror dropout all; do
            train "short-whole-without-$part" cascade 8 $whole --ablate "$part"
        done
    fi
    "$run" evaluate image --recipe "$recipe" -o "runs/image-$recipe"
    epochs=32
done

recipe=leave-one-out # 20 minutes of one core for each network, panel-pool 30
"$run" build "$recipe" --count 1000 -o "data/$recipe"
for kind in one-panel-dress one-panel-jumpsuit top-skirt top-pants shirt skirt pants tee tank jacket \
    hoodie; do
    train "cascade-$kind" cascade 6 --without "$kind"
done
for kind in top-skirt tee hoodie; do
    train "panel-transformer-$kind" panel-transformer 2 --rate 0.0005 --batch 32 --without "$kind"
    train "panel-recurrent-$kind" panel-recurrent 3 --rate 0.004 --without "$kind"
    train "panel-pool-$kind" panel-pool 6 --without "$kind"
done
"$run" evaluate image --recipe "$recipe" --seen 100 --unseen 49 --parts 25 --draped 10 \
    -o "runs/image-$recipe"

"$run" build "$recipe" --count 2000 -o data/wide
"$run" train cascade --data data/wide --epochs 32 -o runs/image-wide
"$run" evaluate image --data data/wide --network wide=runs/image-wide --seen 500 --parts 200 --draped 100 \
    -o runs/image-wide-figures
