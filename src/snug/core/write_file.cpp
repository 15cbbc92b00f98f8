// write_file: a whole file or none.
#include "snug/core/write_file.hpp"

namespace snug {

void write_file(OutputFile file, std::string_view bytes) {
  file.write(bytes);
  file.publish();
}

}  // namespace snug
