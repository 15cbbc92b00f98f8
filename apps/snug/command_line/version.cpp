// version: what this program is; alone in its file, as the commit changes often.
#include "apps/snug/command_line/version.hpp"

#include <version_text.hpp>

namespace snug::app {

const char* version_text() { return SNUG_VERSION; }

}  // namespace snug::app
