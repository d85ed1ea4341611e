#!/usr/bin/env bash
# Shows that the tests of learning can fail: plants one fault after the other in a copy of the tree (loss, mask, position, sampling of
# each network), builds it and expects the network's test in tests/train/overfit_test.cpp to fail. Prints a table; exit code 1 where a
# test passes with a fault, or fails without one.
# Usage: scripts/planted_faults.sh [-d DIR] [NAME...]   DIR: folder for the copy, kept; NAME: faults whose name contains it
set -euo pipefail
cd "$(dirname "$0")/.."
folder=
while getopts d: option; do
  case $option in d) folder=$OPTARG ;; *) exit 2 ;; esac
done
shift $((OPTIND - 1))
if [ -z "$folder" ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
rm -rf "$folder/clean"
mkdir -p "$folder/clean" "$folder/tree"
git ls-files -z -co --exclude-standard | while IFS= read -r -d '' file; do
  [ ! -f "$file" ] || install -D "$file" "$folder/clean/$file"
done
# Files that are alike keep their time, so that a kept folder builds little. What the repository lost, the copy loses.
(cd "$folder/tree" && find . -path ./build -prune -o -type f -print0) | while IFS= read -r -d '' file; do
  [ -f "$folder/clean/$file" ] || rm "$folder/tree/$file"
done
(cd "$folder/clean" && find . -type f -print0) | while IFS= read -r -d '' file; do
  cmp -s "$folder/clean/$file" "$folder/tree/$file" || install -D "$folder/clean/$file" "$folder/tree/$file"
done
cd "$folder/tree"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
cmake --preset test -DMOCURATE_SLICE=learn >"$folder/cmake.log"
build() { cmake --build --preset test --target test_train >"$folder/build.log" 2>&1 || { tail -20 "$folder/build.log"; return 1; }; }
runs() { (cd build/test/tests && ../bin/test_train --gtest_brief=1 --gtest_filter="$1" >"$folder/test.log" 2>&1); }

status=0 planted=0
printf '| network | fault | test |\n|---|---|---|\n'
# fault NETWORK WHAT FILE PERL-SUBSTITUTION TESTS
fault() {
  local name="$1: $2" chosen=${#wanted[@]}
  for part in "${wanted[@]}"; do [[ $name != *"$part"* ]] || chosen=0; done
  [ "$chosen" -eq 0 ] || return 0
  perl -0pi -e "$4" "$3"
  if cmp -s "$3" "$folder/clean/$3"; then
    echo "planted_faults.sh: $name: nothing in $3 to change" >&2
    status=1
    return 0
  fi
  planted=$((planted + 1))
  if ! build; then
    echo "planted_faults.sh: $name: the copy does not build" >&2
    status=1
  elif runs "$5"; then
    printf '| %s | %s | PASSES |\n' "$1" "$2"
    status=1
  elif grep -q '\[  FAILED  \]' "$folder/test.log"; then
    printf '| %s | %s | fails |\n' "$1" "$2"
  else
    printf '| %s | %s | CRASHES |\n' "$1" "$2"
    status=1
  fi
  cp "$folder/clean/$3" "$3"
}
wanted=("$@")
build
if ! runs '*Overfit*'; then
  cat "$folder/test.log"
  echo "planted_faults.sh: a test fails without a fault" >&2
  exit 1
fi

networks=train/networks
a2m='*OverfitAction2Motion*'
lie='*OverfitAction2Motion*/1'
fault 'Action2Motion' 'loss: the root alone is compared' $networks/action2motion.cpp \
  's/\(joints - batch\.motion\)\.square\(\)/(joints - batch.motion).slice(2, 0, 3).square()/' "$a2m"
fault 'Action2Motion' 'loss: KL is rewarded' $networks/action2motion.cpp \
  's/reconstruction\.sum\(\) \+ kl_weight_/reconstruction.sum() - kl_weight_/' "$a2m"
fault 'Action2Motion' 'position: the time of generated frames runs backwards' $networks/action2motion.cpp \
  's/torch::cat\(\{before, condition\[t\]\}, 1\)/torch::cat({before, condition[T - 1 - t]}, 1)/' "$lie"
fault 'Action2Motion' 'sampling: noise without the mean of the prior' $networks/action2motion.cpp \
  's/torch::addcmul\(prior_->mu_net->forward\(state\), noise\[t\], deviation\)/noise[t] * deviation/' "$a2m"
fault 'Action2Motion' 'sampling: generated poses are not fed back' $networks/action2motion.cpp \
  's/before = feed_joints_ \? Joints\(y, requests\.bone_length\) : y;/before = torch::zeros_like(y);/' "$a2m"
fault 'Action2Motion' 'rotations: angles of at most 0.1 rad' $networks/action2motion.cpp \
  's/torch::tanh\(rotations\) \* kReleasedPi/torch::tanh(rotations) * 0.1/' "$lie"

fault 'CondGRU' 'loss: each frame against the one before' $networks/cond_gru.cpp \
  's/output - batch\.motion\.slice\(0, 1\)/output - batch.motion.slice(0, 0, -1)/' '*CondGru*'
fault 'CondGRU' 'sampling: generated poses are not fed back' $networks/cond_gru.cpp \
  's/pose = linear_output_->forward\(state\);\n    output\[t\]\.copy_\(pose\);/output[t].copy_(linear_output_->forward(state));/' \
  '*CondGru*'

actor='*ActorDecodes*'
fault 'ACTOR' 'loss: places are not compared' $networks/actor.cpp \
  's/const Tensor pose = \(decoded - truth\)\.square\(\)/const Tensor pose = (decoded - truth).slice(2, 0, -width_).square()/' \
  "$actor"
fault 'ACTOR' 'mask: padding is read as frames' $networks/actor_coders.cpp \
  's/motion\.valid\.t\(\)\.logical_not\(\) : Tensor\(\)/torch::zeros_like(motion.valid.t()) : Tensor()/' "$actor"
fault 'ACTOR' 'mask: valid frames are taken for padding' train/trainer/trainer.cpp \
  's/torch::arange\(made\.frames\)\.unsqueeze\(1\) < length/torch::arange(made.frames).unsqueeze(1) >= length - 6/' "$actor"
fault 'ACTOR' 'position: the decoder has none' $networks/actor_coders.cpp \
  's/dropout\(PositionalTable\(T, latent\)\.to/dropout(torch::zeros({T, 1, latent}).to/' "$actor"
fault 'ACTOR' 'sampling: the class of the request is ignored' $networks/actor.cpp \
  's/decoder_->Generate\(z, requests\.label, T\)/decoder_->Generate(z, torch::zeros_like(requests.label), T)/' "$actor"

macvae='*OverfitSamples*/0'
fault 'MACVAE' 'loss: frames against their neighbours' $networks/macvae.cpp \
  's/frames\.read\.slice\(0, 0, count\)\)\.abs\(\)/frames.read.slice(0, 0, count).roll(1, 0)).abs()/' "$macvae"
fault 'MACVAE' 'loss: KL is rewarded' $networks/macvae.cpp \
  's/options_\.kl_weight \* kl/-options_.kl_weight * kl/' "$macvae"
fault 'MACVAE' 'mask: the previous motion alone counts' $networks/macvae.cpp \
  's/Tensor counted = \(time < end\)/Tensor counted = (time < parts.select(1, 0))/' "$macvae"
fault 'MACVAE' 'position: the decoder has none' $networks/macvae_coders.cpp \
  's/return torch::cat\(\n      \{first\.expand\(/return 0.0 * torch::cat(\n      {first.expand(/' "$macvae"
fault 'MACVAE' 'sampling: noise without the mean of the prior' $networks/macvae.cpp \
  's/const Tensor z = prior\.mean \+ /const Tensor z = /' "$macvae"

ssmct='*OverfitSamples*/1'
fault 'SSMCT' 'loss: the root alone is compared' $networks/ssmct.cpp \
  's/\(made - truth\)\.abs\(\)\.sum\(\)/(made - truth).slice(1, 6 * joints_).abs().sum()/;
   s/\(joints - JointsOf\(truth\)\)\.abs\(\)/(joints - JointsOf(truth)).slice(1, 0, 1).abs()/' "$ssmct"
fault 'SSMCT' 'mask: padding in the place of the transition' $networks/ssmct.cpp \
  's/return torch::where\(missing\.unsqueeze\(2\)/return torch::where(padded.unsqueeze(2)/' "$ssmct"
fault 'SSMCT' 'sampling: the answer is a frame late' $networks/ssmct.cpp \
  's/parts\.options\(\)\)\.unsqueeze\(1\) \+ begin;/parts.options()).unsqueeze(1) + begin + 1;/' "$ssmct"

for network in gru_recogniser:0 st_gcn:1; do
  fault "${network%:*}" 'loss: of the next class' "$networks/${network%:*}.cpp" \
    's/gather\(1, batch\.label\.unsqueeze\(1\)\)/gather(1, ((batch.label + 1) % log_probability.size(1)).unsqueeze(1))/' \
    "*OverfitRecogniser*/${network#*:}"
  fault "${network%:*}" 'loss: sign flipped' "$networks/${network%:*}.cpp" \
    's/= (-?)log_probability\.gather\(1, batch/"= " . ($1 ? "" : "-") . "log_probability.gather(1, batch"/e' \
    "*OverfitRecogniser*/${network#*:}"
done

moco='OverfitGan.ActMoCoGan*'
fault 'Act-MoCoGAN' 'loss: discriminator target 1 for generated motions' $networks/act_mocogan.cpp \
  's/GanLoss\(fake\.select\(1, 0\), 0\.0/GanLoss(fake.select(1, 0), 1.0/' "$moco"
fault 'Act-MoCoGAN' 'loss: generator target 0' $networks/act_mocogan.cpp \
  's/GanLoss\(logits\.select\(1, 0\), 1\.0/GanLoss(logits.select(1, 0), 0.0/' "$moco"
fault 'Act-MoCoGAN' 'sampling: the class is not read' $networks/act_mocogan.cpp \
  's/OneHot\(label, classes_\)\.unsqueeze\(0\)/torch::zeros({1, label.size(0), classes_})/' "$moco"
two='OverfitGan.TwoStage*'
fault 'Two-stage GAN' 'loss: pose critic, sign flipped' $networks/two_stage_gan.cpp \
  's/\(JudgePoses\(made\.detach\(\), made_of\)\.sum\(\) - JudgePoses\(real, OneHot\(batch\.label, classes_\)\)\.sum\(\)\)/(JudgePoses(real, OneHot(batch.label, classes_)).sum() - JudgePoses(made.detach(), made_of).sum())/' \
  "$two"
fault 'Two-stage GAN' 'loss: motion generator, sign flipped' $networks/two_stage_gan.cpp \
  's/losses\.total = -JudgeMotion\(Motion/losses.total = JudgeMotion(Motion/' "$two"
fault 'Two-stage GAN' 'sampling: the class is not read' $networks/two_stage_gan.cpp \
  's/Motion\(z_0, noise, OneHot\(requests\.label, classes_\)\)/Motion(z_0, noise, OneHot(0 * requests.label, classes_))/' "$two"
echo "planted_faults.sh: $planted faults"
[ "$planted" -gt 0 ] || status=2
exit $status
