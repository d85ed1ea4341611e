#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/ntu_skeleton.h"
#include "ingest/people/person_tracks.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// Names of skeleton ntu25 in the order of the file.
std::vector<std::string> NtuJointNames();

/// The people of a sensor's file, at most `wanted`, in metres and canonical axes. The result includes findings of
/// PeopleOptions' steps. Error kConfig: axes.
Expected<People> NtuPeople(const NtuSkeleton& skeleton, const SourceOptions& source, std::size_t wanted);

/// "zero_joint", set to missing: joints of `body` that the sensor marks as tracked or inferred and puts at 0 0 0.
/// Value: the frames.
void NoteZeroJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings);

/// "inferred_joints": the share of joints of `body` that the sensor inferred instead of observing; a warning above 0.3.
void NoteInferredJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings);

/// Intrinsics fx, fy, cx, cy of the sensor's depth images, from joints given in metres and in pixels: u = fx x / z + cx
/// with x to the sensor's left (its images are mirrored) and v = cy - fy y / z. Nothing where joints lie too close
/// together, or pixels and metres disagree by more than half a pixel.
std::optional<std::array<double, 4>> NtuIntrinsics(const NtuSkeleton& skeleton);

/// The .skeleton files of one performance, one per camera -> evidence tracks of one of its people, in the world of one
/// camera, and depth views. Camera poses and clock offsets, which are not published, are estimated from the joints
/// (core/quality/view_alignment.h); provenance holds each number with its uncertainty. A camera without the person, or
/// whose joints fit no other or only mirrored, is excluded with a finding. Refused are a clip without the person, and
/// one where no two cameras agree while two contradict each other.
Expected<IngestedClip> ReadNtuViewsClip(const SourceFile& file);

}  // namespace mocurate
