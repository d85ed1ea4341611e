#include <algorithm>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

class LabelledFolderWriter : public LayoutWriter {
 public:
  LabelledFolderWriter(const ExportSet& set, const LabelledFolder& folder)
      : set_(set), folder_(folder), names_(set.ids, RecordingNames::kOfPerson) {}

  Expected<std::vector<ExportedFile>> Add(std::size_t position, const Clip& clip) override {
    if (!folder_.holds_rate) {
      if (Status same = rate_.Check(clip); !same) return Forward(same);
    }
    Expected<std::string> bytes = folder_.encode(clip, set_);
    if (!bytes) return Forward(bytes);
    std::string path = labels_.Of(clip.label) + "/";
    if (!clip.fine_label.empty()) path += fine_labels_.Of(clip.fine_label) + "/";
    path += names_.Person(position) + "/" + names_.Recording(position) + folder_.ending;
    clips_.push_back(WrittenClipOf(position, clip, path));
    clips_.back().person = names_.Person(position);
    return std::vector<ExportedFile>{{std::move(path), *std::move(bytes)}};
  }

  void RemoveLast() override { clips_.pop_back(); }

  Expected<std::vector<ExportedFile>> Finish(std::vector<std::string>& notes) override {
    NoteNames(notes);
    std::vector<ExportedFile> files = {ClipTable(set_, clips_)};
    if (clips_.empty() || folder_.declare == nullptr) return files;
    const FrameRate& first = clips_.front().rate;
    const bool one_rate =
        std::all_of(clips_.begin(), clips_.end(), [&](const WrittenClip& c) { return c.rate == first; });
    if (folder_.declares_rate && !one_rate) {
      notes.push_back(
          "the clips have different rates: no source.yaml is written, because it can declare one rate only");
      return files;
    }
    FileDeclaration declaration;
    declaration.layout = folder_.layout;
    declaration.source = names_.source();
    declaration.has_tree = folder_.holds_tree;
    declaration.joint_table = folder_.joint_table;
    declaration.options = folder_.declare(set_, first);
    const bool fine = !fine_labels_.Texts().empty();
    const auto say = [&](const char* option, const std::string& value) {
      declaration.options.emplace_back(option, value);
    };
    say("files",
        YamlQuoted(std::string("{label}/") + (fine ? "{fine?/}" : "") + "{person}/{recording}" + folder_.ending));
    say("other_files", "ignore");
    say("axes", YamlQuoted("+x +y +z"));
    say("person", YamlQuoted("{person}"));
    say("recording", YamlQuoted("{recording}"));
    say("label", YamlQuoted("{label}"));
    if (labels_.renamed() > 0) say("labels", YamlMap(labels_.Texts()));
    if (fine) say("fine_label", YamlQuoted("{fine}"));
    if (fine_labels_.renamed() > 0) say("fine_labels", YamlMap(fine_labels_.Texts()));
    AddDeclaration(set_, clips_, declaration, notes, files);
    return files;
  }

 private:
  void NoteNames(std::vector<std::string>& notes) const {
    for (const auto& [renamed, noun] :
         {std::pair(names_.renamed(), "recording"), {names_.renamed_persons(), "person"}}) {
      if (renamed == 0) continue;
      notes.push_back(Counted(static_cast<long long>(renamed), noun) +
                      " come back with the file names; clips.csv has the clips' ids");
    }
    if (const std::size_t renamed = labels_.renamed() + fine_labels_.renamed(); renamed > 0) {
      notes.push_back(Counted(static_cast<long long>(renamed), "label") +
                      " got another name as folder; clips.csv has the labels");
    }
    const std::vector<std::string> joints = JointNamesForFile(*set_.skeleton, folder_.not_in_joint_names);
    std::string renamed;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const std::string& name = set_.skeleton->joints[j].name;
      if (joints[j] != name) renamed += (renamed.empty() ? "" : ", ") + joints[j] + " for '" + name + "'";
    }
    if (!renamed.empty()) notes.push_back("names of joints in the files: " + renamed);
  }

  const ExportSet set_;
  const LabelledFolder folder_;
  const ClipNames names_;
  OneRate rate_;
  FileNames labels_{{kClipTable, kDeclarationFile, kSkeletonFile}};
  FileNames fine_labels_;
  std::vector<WrittenClip> clips_;
};

}  // namespace

std::unique_ptr<LayoutWriter> MakeLabelledFolder(const ExportSet& set, const LabelledFolder& folder) {
  return std::make_unique<LabelledFolderWriter>(set, folder);
}

}  // namespace mocurate
