#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/ntu_skeleton.h"
#include "ingest/people/choose_people.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// Names of skeleton ntu25 in the order of the file.
std::vector<std::string> NtuJointNames();

/// Who is who in a file of the sensor, in metres and canonical axes: at most `wanted` people. Findings of
/// PeopleOptions' steps are in the result. Error kConfig: axes.
Expected<People> NtuPeople(const NtuSkeleton& skeleton, const SourceOptions& source, std::size_t wanted);

/// "zero_joint", taken as missing: joints of `body` that the sensor says it tracks or infers, and puts at 0 0 0; value
/// the frames.
void NoteZeroJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings);

/// "inferred_joints": the share of joints of `body` that the sensor inferred instead of seeing them; a warning above
/// 0.3.
void NoteInferredJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings);

/// Of a file that holds fewer people than `wanted`: the `own`-th of them, from 1, is not there. `name` for messages.
Error PersonNotThere(std::size_t own, std::size_t wanted, const People& people, std::size_t frames,
                     const std::string& name);

/// Of the sensor's depth images as its own joints tell them, which stand in metres and in pixels: fx, fy, cx, cy, for
/// u = fx x / z + cx with x to the sensor's left (its images are mirrored) and v = cy - fy y / z. Nothing where joints
/// lie too near together, or pixels and metres do not belong to each other within half a pixel.
std::optional<std::array<double, 4>> NtuIntrinsics(const NtuSkeleton& skeleton);

/// The .skeleton files of one performance, one per camera -> evidence tracks of one of its people, merged in the world
/// of one of the cameras, and depth views. The cameras' places and clocks, which nobody publishes, are found from the
/// joints that they follow (core/quality/view_alignment.h): provenance says each number and how sure it is. A
/// camera that saw nobody, whose joints fit no other or only mirrored is left out with a finding. Refused are a clip
/// that nobody saw and one of which no two cameras agree while two contradict each other.
Expected<IngestedClip> ReadNtuViewsClip(const SourceFile& file);

}  // namespace mocurate
