#pragma once

#include <string>

#include "tests/store/builders.h"

namespace mocurate::test {

/// A dataset whose numbers come from additions, products and square roots alone: the same bytes on every machine of one
/// architecture. Every third clip is without optional fields, every fifth of a person with other hips.
inline Dataset FixedDataset(int clips, int frames, bool joints_only = false) {
  const Quaterniond turns[] = {Quaterniond::Identity(), Quaterniond(0.5, 0.5, 0.5, 0.5),
                               Quaterniond(0.5, -0.5, 0.5, 0.5), Quaterniond(0, 1, 0, 0)};
  Dataset dataset;
  dataset.skeleton = Walker();
  dataset.joints_only = joints_only;
  const int J = dataset.skeleton->joint_count();
  for (int c = 0; c < clips; ++c) {
    const std::string number = std::to_string(1000 + c);
    Clip clip = MakeClip("p" + std::to_string(1 + c / 10), number, frames + c % 7);
    const int F = clip.identity.end_frame - clip.identity.begin_frame;
    clip.canonical_from_source = {Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3}};
    clip.label = c % 2 == 0 ? "walk" : "run";
    const SkeletonPtr body = c % 5 == 4 && !joints_only ? OtherWalker() : dataset.skeleton;
    std::vector<Vector3d> root;
    std::vector<Quaterniond> rotation;
    for (int f = 0; f < F; ++f) {
      root.emplace_back(0.125 * (f % 32), 1.0 + 0.0625 * (c % 4), 0.25 * c);
      for (int j = 0; j < J; ++j) rotation.push_back(turns[(f + j + c) % 4]);
    }
    std::vector<double> bones(static_cast<std::size_t>(J), 0.5);
    bones[0] = 0.0;
    clip.motion = MakeMotion(body, clip.rate, root, rotation, bones);
    if (joints_only) clip.motion = MakeJointsOnly(dataset.skeleton, clip.rate, clip.motion->joints);
    Motion& motion = *clip.motion;
    for (int cell = 0; c % 3 != 0 && cell < F * J; ++cell) {
      motion.state.push_back(static_cast<JointState>(cell % 4));
      for (int k = 0; k < 6; ++k) motion.position_cov.push_back(0.0009765625f * static_cast<float>((cell + k) % 8));
      for (int k = 0; k < 3; ++k) motion.rotation_sigma.push_back(0.03125f * static_cast<float>((cell + k) % 5));
      for (int k = 0; k < 3; ++k) motion.rotation_observed.push_back(0.25f * static_cast<float>((cell + k) % 4));
    }
    for (int i = 0; c % 3 == 1 && i < 2 * F; ++i) motion.contact.push_back(static_cast<std::uint8_t>(i % 2));
    dataset.clips.push_back(std::move(clip));
  }
  dataset.labels = {"run", "walk", "jump"};
  Split split;
  split.name = "by_person";
  for (int c = 0; c < clips; ++c) (c < 10 ? split.test : split.train).push_back(c);
  split.rule = "test: p1";
  split.leak_check = "ok: no person in two parts";
  dataset.splits = {split};
  dataset.findings = {{dataset.clips[0].id(), "skate", Severity::kWarning, 1, 3, "left_knee", 0.25, 0.0, "slides",
                       FindingAction::kKept}};
  dataset.recipe = "fixed\n";
  dataset.created_by = "tests";
  return dataset;
}

}  // namespace mocurate::test
