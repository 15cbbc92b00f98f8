// merge_archives, find_defects: archives as wholes.
#include <map>

#include "snug/record/archive.hpp"

namespace snug::record {

std::vector<InputError> find_defects(const ArchiveReader& reader) {
  std::vector<InputError> defects;
  for (std::size_t i = 0; i < reader.size(); ++i)
    for (InputError& defect : reader.find_defects(i)) defects.push_back(std::move(defect));
  return defects;
}

void merge_archives(const std::vector<std::filesystem::path>& archives, OutputFile file) {
  ArchiveWriter writer(std::move(file));
  std::map<std::string, ArchiveObject> objects;
  std::string sequence, sequence_of;
  for (const std::filesystem::path& path : archives) {
    const ArchiveReader reader(path);
    for (std::size_t i = 0; i < reader.size(); ++i) {
      const ArchiveRecording recording = reader.read(i);
      const std::string here(find_remark(recording, "sequence"));
      if (!here.empty() && !sequence.empty() && here != sequence)
        throw InputError(path.string(), '/' + recording.name, "sequence '" + here + "'",
                         "'" + sequence + "', that of " + sequence_of);
      if (sequence.empty()) sequence_of = path.string();
      if (sequence.empty()) sequence = here;
      for (const ArchiveObject& object : recording.objects) {
        const auto [at, is_new] = objects.emplace(object.name, object);
        if (!is_new && (at->second.mass != object.mass || at->second.dimensions != object.dimensions))
          throw InputError(path.string(), '/' + recording.name + "/OBJECT/" + object.name, "another mass or size",
                           "what the recordings before it have");
      }
      writer.add(recording);
    }
  }
  writer.close();
}

}  // namespace snug::record
