#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/store/array.h"
#include "core/store/store.h"

/// Between the value types of core/motion and the fields of the table. Pack* refuse what has inconsistent shapes;
/// Unpack* need checked content. `prefix` is "" or "/truth".
namespace mocurate::store {

/// Bit i of /clips/field_mask is for entry i (OptionalFieldsOf).
inline constexpr std::array<const char*, 5> kOptionalFrameFields = {"state", "position_cov", "rotation_sigma",
                                                                    "rotation_observed", "contact"};

void PackSkeleton(const Skeleton& skeleton, const std::string& prefix, Content& content);
Skeleton UnpackSkeleton(const Content& content, const std::string& prefix);
/// Whether two skeletons agree in everything that is stored.
bool SameSkeleton(const Skeleton& a, const Skeleton& b);
/// Whether they do but for their rest offsets, which a file keeps of each clip.
bool SameButRestOffsets(const Skeleton& a, const Skeleton& b);
/// The skeleton with the rest offsets of a row of /clips/rest_offset; `skeleton` itself where they are its own.
SkeletonPtr WithRestOffsets(const Content& content, const std::string& prefix, std::size_t row,
                            const SkeletonPtr& skeleton);

/// Properties of a motion without its frames.
struct MotionRow {
  std::string id;
  const Motion* motion;          ///< skeleton, rate, counts of frames and joints, bone lengths
  std::uint8_t optional_fields;  ///< bits of kOptionalFrameFields that it has
};
/// Writes the spans in /clips, and of /frames types and shapes (Content::later). Error kInconsistent naming the clip.
Status PackOutlines(const std::vector<MotionRow>& rows, const Skeleton& skeleton, bool joints_only,
                    const std::string& prefix, Content& content);
/// Whether a motion has as many values as its frames ask for, and rotations where they are wanted. Error kInconsistent.
Status CheckFrames(const std::string& id, const Motion& motion, bool joints_only);
/// Writes /frames of one motion, with the optional fields that some motion of the file has (`present`).
void PackFrames(const Motion& motion, unsigned present, bool joints_only, const std::string& prefix, Content& content);
/// A motion without frames: what PackOutlines wrote of it.
Motion UnpackOutline(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton, std::size_t row);
std::vector<Motion> UnpackMotions(const Content& content, const std::string& prefix, const SkeletonPtr& skeleton);

/// Labels and fine labels, and the classes of the clips.
void PackLabels(const Dataset& dataset, Content& content);
/// Error kInconsistent: two of one name.
Status PackSplits(const std::vector<Split>& splits, Content& content);
std::vector<Split> UnpackSplits(const Content& content);
void PackFindings(const std::vector<Finding>& findings, Content& content);
std::vector<Finding> UnpackFindings(const Content& content);
/// Fields of a dataset other than skeleton and clips.
void UnpackDatasetParts(const Content& content, Dataset& dataset);
/// Errors of packing get the file's name before the clip's.
Status InFile(Status status, const std::filesystem::path& path);
/// Whether clip and motion agree on the rate. Error kInconsistent naming the clip.
Status CheckRates(const Clip& clip, const std::filesystem::path& path);

/// Identity, labels, segments, provenance; not motion and evidence.
void PackClips(const std::vector<const Clip*>& clips, Content& content);
std::vector<Clip> UnpackClips(const Content& content);
ClipIdentity IdentityOf(const Content& content, std::size_t row);
/// In lowest terms: equal rates have one text.
std::string TextOfRate(const FrameRate& rate);
/// The rate all agree on, else "mixed".
std::string CommonRate(const std::vector<std::string>& rates);
/// What /about says of the clips; empty where none of them notes its origin.
std::string AboutText(const std::vector<const Clip*>& clips);

Status PackEvidence(const Evidence& evidence, Content& content);
Evidence UnpackEvidence(const Content& content);

/// Seven numbers: w x y z of the rotation, then the translation.
void AppendTransform(std::vector<double>& values, const RigidTransform& transform);
RigidTransform TransformFrom(const std::vector<double>& values, std::size_t row);

/// A unit quaternion from four stored numbers (w, x, y, z) whose norm is nearly 1.
Quaterniond ReadQuaternion(const float* stored);
/// The four numbers stored for `rotation`: a quaternion read and stored again keeps its bits.
std::array<float, 4> StoredQuaternion(const Quaterniond& rotation);

}  // namespace mocurate::store
