#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/train/chains.h"

namespace mocurate {

/// Joints-only clips of four persons: class 0 waves slowly, class 1 quickly, class 2 walks. Split by person.
inline Dataset ToyDataset(int clips_per_person_and_class) {
  Dataset dataset;
  dataset.skeleton = SmallSkeleton();
  dataset.joints_only = true;
  dataset.labels = {"slow", "quick", "walk"};
  Split split;
  split.name = "person";
  for (int person = 0; person < 4; ++person) {
    for (int label = 0; label < 3; ++label) {
      for (int k = 0; k < clips_per_person_and_class; ++k) {
        Clip clip;
        clip.identity.source = "toy";
        clip.identity.person = "p" + std::to_string(person);
        clip.identity.recording = dataset.labels[static_cast<std::size_t>(label)] + std::to_string(k);
        Random random(7, "toy", clip.id());
        const int frames = 20 + static_cast<int>(random.Below(12));
        clip.identity.end_frame = frames;
        clip.label = dataset.labels[static_cast<std::size_t>(label)];
        Motion motion;
        motion.skeleton = dataset.skeleton;
        motion.joints = JointPositions(frames, 5);
        const double size = 1.0 + 0.1 * person, phase = random.Uniform(0.0, 0.5);
        for (int f = 0; f < frames; ++f) {
          const double t = static_cast<double>(f) / frames;
          const Vector3d root(0.0, 1.0, label == 2 ? t : 0.0);
          const double angle = std::sin(6.28 * ((label == 1 ? 4.0 : 1.0) * t + phase));
          const Vector3d arm(std::sin(angle), std::cos(angle), 0.0);
          motion.joints.at(f, 0) = root;
          motion.joints.at(f, 1) = root + size * Vector3d(0, 0.3, 0);
          motion.joints.at(f, 2) = root + size * (Vector3d(0, 0.3, 0) + 0.3 * arm);
          motion.joints.at(f, 3) = root - size * Vector3d(0, 0.4, 0);
          motion.joints.at(f, 4) = root - size * Vector3d(0, 0.8, 0);
        }
        clip.motion = std::move(motion);
        dataset.clips.push_back(std::move(clip));
      }
    }
  }
  std::sort(dataset.clips.begin(), dataset.clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    (dataset.clips[row].identity.person == "p3" ? split.test : split.train).push_back(static_cast<int>(row));
  }
  dataset.splits = {split};
  return dataset;
}

/// The same with rotations: the arm rotates, the others stay.
inline Dataset TurningDataset(int clips_per_person_and_class) {
  Dataset dataset = ToyDataset(clips_per_person_and_class);
  dataset.joints_only = false;
  for (Clip& clip : dataset.clips) {
    const JointPositions& joints = clip.motion->joints;
    std::vector<Vector3d> root;
    std::vector<Quaterniond> rotation(static_cast<std::size_t>(joints.frames) * 5, Quaterniond::Identity());
    std::vector<double> lengths(5, 0.0);
    for (int j = 1; j < 5; ++j) {
      lengths[static_cast<std::size_t>(j)] =
          (joints.at(0, j) - joints.at(0, dataset.skeleton->joints[static_cast<std::size_t>(j)].parent)).norm();
    }
    for (int f = 0; f < joints.frames; ++f) {
      root.emplace_back(joints.at(f, 0));
      rotation[static_cast<std::size_t>(5 * f + 1)] =
          SwingBetween(Vector3d(0, 1, 0), joints.at(f, 2) - joints.at(f, 1));
    }
    clip.motion = MakeMotion(dataset.skeleton, clip.rate, std::move(root), std::move(rotation), std::move(lengths));
  }
  return dataset;
}

/// The same as samples of two actions: the first third is the previous action, then four frames of transition. The
/// previous action of each is another class; persons face different ways and walk.
inline Dataset SampleDataset(int clips_per_person_and_class) {
  Dataset dataset = TurningDataset(clips_per_person_and_class);
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    Clip& clip = dataset.clips[i];
    Motion& motion = *clip.motion;
    const Quaterniond facing(Eigen::AngleAxisd(0.5 * static_cast<double>(i % 5), Vector3d::UnitY()));
    for (int f = 0; f < motion.frame_count(); ++f) {
      motion.rotation_at(f, 0) = facing;
      motion.root_translation[static_cast<std::size_t>(f)] += Vector3d(0.01 * f, 0.0, 0.1 * static_cast<double>(i % 3));
    }
    ComputeJoints(motion);
    const int all = motion.frame_count(), first = all / 3;
    const auto other = static_cast<std::size_t>((dataset.LabelIndex(clip.label) + 1) % 3);
    const auto segment = [&](int begin, int end, const std::string& label) {
      return Segment{motion.rate.FrameTime(begin), motion.rate.FrameTime(end), label, "", "triple"};
    };
    clip.segments = {segment(0, first, i % 4 == 0 ? "bow" : dataset.labels[other]),
                     segment(first, first + 4, "transition"), segment(first + 4, all, clip.label)};
    clip.canonical_from_source.translation = Vector3d(0.0, -1.0, 0.5);
  }
  return dataset;
}

}  // namespace mocurate
