#include "ingest/sources/frame_files.h"

#include <algorithm>
#include <optional>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/formats/row_counter.h"

namespace mocurate {
namespace {

constexpr const char* kFirstFrame = "ingest.source.first_frame";
constexpr std::size_t kFewestOfClock = 8;  // numbers of a camera, for their steps to tell

bool BelongTogether(const std::set<long long>& a, const std::set<long long>& b, std::size_t shared, bool declared) {
  if (declared) return *a.begin() <= *b.rbegin() + 1 && *b.begin() <= *a.rbegin() + 1;
  return 2 * shared >= std::min(a.size(), b.size());
}

std::size_t SharedNumbers(const std::set<long long>& a, const std::set<long long>& b) {
  return static_cast<std::size_t>(
      std::count_if(a.begin(), a.end(), [&](long long number) { return b.count(number) != 0; }));
}

ViewNumbers NumbersOf(const CameraFiles& cameras, const char* suffix) {
  ViewNumbers views;
  for (const auto& [camera, files] : cameras) {
    for (const auto& [number, input] : files) views[camera + suffix].insert(number);
  }
  return views;
}

/// Numbers of a camera that a clock gave, as names of images with times have them.
Status CheckNumbers(const SourceFile& file, const ViewNumbers& views) {
  for (const auto& [camera, numbers] : views) {
    if (numbers.size() < kFewestOfClock) continue;
    const CounterEstimate estimate = EstimateCounter({numbers.begin(), numbers.end()});
    if (!IsClock(estimate, {}, file.source.rate_hz.value_or(0.0))) continue;
    Error error{ErrorCode::kInconsistent,
                (camera.empty() ? std::string("the numbers {frame} of the files")
                                : "the numbers {frame} of camera '" + camera + "'") +
                    " are a clock's, by their " + estimate.words,
                file.name, "rename the files by the number of their frame"};
    error.reason = Reason::kOtherLayout;
    return tl::unexpected<Error>(std::move(error));
  }
  return {};
}

void ShiftNumbers(long long by, FilesOfCamera& files) {
  FilesOfCamera shifted;
  for (const auto& [number, input] : files) shifted.emplace(number + by, input);
  files = std::move(shifted);
}

/// Brings the cameras of first_frame to the numbers of the others. Returns the names of those that the clip has.
std::set<std::string> FollowFirstFrames(const SourceOptions& source, const std::vector<CameraFiles*>& all) {
  std::set<std::string> declared;
  std::optional<long long> first, lowest;
  for (const auto* cameras : all) {
    for (const auto& [camera, files] : *cameras) {
      if (files.empty()) continue;
      const std::optional<long long> own = FirstFrameOf(source, camera);
      std::optional<long long>& least = own ? lowest : first;
      const long long number = own ? *own : files.begin()->first;
      least = std::min(least.value_or(number), number);
      if (own) declared.insert(camera);
    }
  }
  const long long begin = first ? *first : lowest.value_or(0);
  for (auto* cameras : all) {
    for (auto& [camera, files] : *cameras) {
      const std::optional<long long> own = FirstFrameOf(source, camera);
      if (own) ShiftNumbers(begin - *own, files);
    }
  }
  return declared;
}

}  // namespace

std::string ApartView::Words() const {
  const auto range = [](long long from, long long to) { return std::to_string(from) + " to " + std::to_string(to); };
  return "camera '" + camera + "' is numbered " + range(first, last) + ", '" + other + "' " +
         range(other_first, other_last) + ", an offset of " + std::to_string(offset()) + ": they share " +
         std::to_string(shared) + " of " + Counted(static_cast<long long>(shorter), "frame");
}

std::vector<ApartView> FindApartViews(const ViewNumbers& views, const std::set<std::string>& declared) {
  std::vector<const ViewNumbers::value_type*> cameras;
  for (const auto& view : views) {
    if (!view.second.empty()) cameras.push_back(&view);
  }
  std::vector<std::size_t> group(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    group[i] = i;
    for (std::size_t k = 0; k < i; ++k) {
      const auto &a = *cameras[i], &b = *cameras[k];
      const bool said = declared.count(a.first) + declared.count(b.first) > 0;
      if (!BelongTogether(a.second, b.second, SharedNumbers(a.second, b.second), said)) continue;
      const std::size_t from = group[i], to = group[k];
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  const auto size = [&](std::size_t of) { return std::count(group.begin(), group.end(), of); };
  std::size_t largest = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (size(group[i]) > size(group[largest])) largest = i;
  }
  std::vector<ApartView> apart;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (group[i] == group[largest]) continue;
    const auto &own = *cameras[i], &other = *cameras[largest];
    apart.push_back({own.first, other.first, *own.second.begin(), *own.second.rbegin(), *other.second.begin(),
                     *other.second.rbegin(), SharedNumbers(own.second, other.second),
                     std::min(own.second.size(), other.second.size())});
  }
  return apart;
}

std::optional<long long> FirstFrameOf(const SourceOptions& source, const std::string& camera) {
  const auto declared = source.first_frame.find(camera);
  return declared == source.first_frame.end() ? std::nullopt : ParseInteger(declared->second);
}

Status CheckFirstFrames(const SourceOptions& source) {
  for (const auto& [camera, number] : source.first_frame) {
    if (ParseInteger(number)) continue;
    return Fail(ErrorCode::kConfig, "camera '" + camera + "' has '" + number + "' for its first frame", kFirstFrame,
                "write the whole number of its frame, e.g. first_frame: {" + camera + ": 440}");
  }
  return {};
}

Status CheckFirstFrames(const SourceOptions& source, const std::set<std::string>& cameras) {
  for (const auto& [camera, number] : source.first_frame) {
    if (cameras.count(camera) != 0) continue;
    const std::vector<std::string> names(cameras.begin(), cameras.end());
    return Fail(ErrorCode::kConfig, "no file is of camera '" + camera + "'", kFirstFrame,
                DidYouMean(camera, names, "the cameras of the files are " + JoinTexts(names)));
  }
  return {};
}

Expected<FrameSpan> MatchViews(const SourceFile& file, CameraFiles& cameras, CameraFiles* depth, CameraFiles* masks) {
  std::vector<CameraFiles*> all = {&cameras};
  for (CameraFiles* beside : {depth, masks}) {
    if (beside != nullptr) all.push_back(beside);
  }
  std::set<std::string> declared = FollowFirstFrames(file.source, all);
  ViewNumbers views = NumbersOf(cameras, "");
  if (Status numbers = CheckNumbers(file, views); !numbers) return Forward(numbers);
  CameraFiles together = cameras;
  if (depth != nullptr) {
    // They may be of the same cameras.
    constexpr const char* kBeside = " (depth images)";
    const ViewNumbers images = NumbersOf(*depth, kBeside);
    views.insert(images.begin(), images.end());
    const std::set<std::string> named = declared;
    for (const std::string& camera : named) declared.insert(camera + kBeside);
    for (const auto& [camera, files] : *depth) together[camera].insert(files.begin(), files.end());
  }
  const std::vector<ApartView> apart = FindApartViews(views, declared);
  if (!apart.empty()) {
    const ApartView& first = apart.front();
    Error error{
        ErrorCode::kInconsistent,
        first.Words() + (apart.size() > 1
                             ? "; " + Counted(static_cast<long long>(apart.size()) - 1, "other camera") + " likewise"
                             : ""),
        file.name,
        "where its first file is of the same moment, write ingest.source.first_frame: {" +
            first.camera.substr(0, first.camera.find(" (")) + ": " + std::to_string(first.first) +
            "}; else the number of the file that is, or take the camera out"};
    error.reason = Reason::kViewNumbering;
    error.number = static_cast<double>(first.offset());
    return tl::unexpected<Error>(std::move(error));
  }
  return SpanOf(together, file.name);
}

void NoteMissingFrames(const std::string& camera, const FrameSpan& span, const MissingFrameList& lacking,
                       std::vector<Finding>& findings) {
  constexpr std::size_t kNamed = 5;  // maximum number of files named in a message
  const auto note = [&](const std::vector<int>& frames, const char* code, const std::string& what) {
    Finding finding = CameraFinding(code, static_cast<double>(frames.size()), what, FindingAction::kMissing);
    finding.frame_begin = frames.front();
    finding.frame_end = frames.back() + 1;
    findings.push_back(std::move(finding));
  };
  const std::string of = " of " + Counted(span.frames, "frame");
  if (!lacking.missing.empty()) {
    note(lacking.missing, "frames_missing",
         (camera.empty() ? "there is" : "camera '" + camera + "' has") + " no file for " +
             std::to_string(lacking.missing.size()) + of + ", the first is number " +
             std::to_string(span.first + lacking.missing.front()));
  }
  if (lacking.broken.empty()) return;
  std::string others;
  for (std::size_t i = 1; i < std::min(kNamed, lacking.problems.size()); ++i)
    others += (i == 1 ? "; then " : ", ") + lacking.problems[i].first;
  note(lacking.broken, "unreadable_frames",
       (camera.empty() ? "" : "camera '" + camera + "': ") + "the files of " + std::to_string(lacking.broken.size()) +
           of + " cannot be read; the first: " + lacking.problems[0].second.Message() + others);
}

void ReadFrameFiles(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, const TakeFrame& take,
                    IngestedClip& ingested) {
  MissingFrameList lacking;
  for (int f = 0; f < span.frames; ++f) {
    const auto file = files.find(span.first + f);
    if (file == files.end()) {
      lacking.missing.push_back(f);
      continue;
    }
    const std::string& name = file->second->name;
    const Expected<std::string> bytes = ReadFile(file->second->path);
    ingested.content += name + ' ' + (bytes ? Sha256Hex(*bytes) : "unreadable") + '\n';
    const Status taken = bytes ? take(f, *bytes, name) : Status(Forward(bytes));
    if (taken) continue;
    lacking.broken.push_back(f);
    lacking.problems.emplace_back(name, taken.error());
  }
  NoteMissingFrames(camera, span, lacking, ingested.findings);
}

}  // namespace mocurate
