#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "ingest/folder_listing.h"

namespace mocurate {

/// What a file is, by its first bytes.
enum class FileKind {
  kUnknown,
  kEmpty,
  kBvh,
  kNpy,
  kJson,
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
  kOpenCvYaml,
  kToml,
  kPng,
  kJpeg,
  kVideo,   ///< AVI, MP4 and its kin, Matroska, MPEG
  kSniffed  ///< recognised by a format's driver, not by its first bytes
};

constexpr std::size_t kKindHead = 8192;  ///< bytes at the start of a file that KindOf looks at

FileKind KindOf(std::string_view bytes);

/// What a JSON file is, by its keys; kOther: none of these, it may be a calibration.
enum class JsonKind {
  kOther,
  kDepthSequence,
  kDepthStill,
  kOpenPose,
  kPanopticBodies,
  kBabel,
  kBandaiLabel,
  kList,        ///< another list: EasyMocap writes [] for a frame without people
  kEasyMocap,   ///< people of EasyMocap, or of a list of COCO's keypoints
  kAzureBodies  ///< body tracking of the Azure Kinect
};

/// Reads no further than it must: at most 64 keys of the top object. kOther for what is no JSON.
JsonKind JsonKindOf(std::string_view bytes);

/// The file, or the files of a folder down to six folders below it, sorted by name. Error kUnreadable.
Expected<std::vector<FolderFile>> FilesToInspect(const std::filesystem::path& path);

/// The first bytes, enough to tell the format. Error kUnreadable.
Expected<std::string> ReadHead(const std::filesystem::path& path);

/// Whether the end of an image's data stands in the last bytes, behind which cameras may put a few of their own.
bool EndsAsJpeg(const std::filesystem::path& path);

}  // namespace mocurate
