#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "ingest/folder_listing.h"

namespace mocurate {

/// What a file is, by its content.
enum class FileKind {
  kUnknown,
  kEmpty,
  kBvh,
  kNpy,
  kC3d,
  kTrc,
  kNumbers,
  kNtuSkeleton,
  kAsf,
  kAmc,
  kOpenSim,
  kZip,
  kPickle,
  kPly,
  kPcd,
  kXml,
  kOpenCvStorage,  ///< YAML or XML
  kToml,
  kPng,
  kJpeg,
  kVideo,  ///< AVI, MP4 and its kin, Matroska, MPEG
  kJson,   ///< of none of those below: it may be a calibration
  kDepthSequence,
  kDepthStill,
  kOpenPose,
  kPanopticBodies,
  kBabel,
  kBandaiLabel,
  kJsonList,
  kEasyMocap,   ///< people of EasyMocap, or of a list of COCO's keypoints
  kAzureBodies  ///< body tracking of the Azure Kinect
};

constexpr std::size_t kKindHead = 8192;  ///< bytes at the start of a file that tell most kinds

/// By the first kKindHead bytes; of JSON by up to 64 keys of the top object, for which the whole file may be needed.
FileKind KindOf(std::string_view bytes);

inline bool IsJson(FileKind kind) { return kind >= FileKind::kJson; }

/// The file, or the files of a folder down to six folders below it, sorted by name. Error kUnreadable.
Expected<std::vector<FolderFile>> FilesToInspect(const std::filesystem::path& path);

/// The first bytes, enough to tell the format. Error kUnreadable.
Expected<std::string> ReadHead(const std::filesystem::path& path);

/// Whether the end of an image's data stands in the last bytes, behind which cameras may put a few of their own.
bool EndsAsJpeg(const std::filesystem::path& path);

}  // namespace mocurate
