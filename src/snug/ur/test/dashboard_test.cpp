// Lines of the dashboard as clients write them.
#include "snug/ur/dashboard.hpp"

#include <gtest/gtest.h>

namespace snug::ur {
namespace {

TEST(Dashboard, ReadsCommandsWhateverTheirCase) {
  EXPECT_EQ(parse_dashboard("power on"), (DashboardLine{DashboardCommand::PowerOn, ""}));
  EXPECT_EQ(parse_dashboard("PolyscopeVersion\r"), (DashboardLine{DashboardCommand::PolyscopeVersion, ""}));
  EXPECT_EQ(parse_dashboard("programState"), (DashboardLine{DashboardCommand::ProgramState, ""}));
  EXPECT_EQ(parse_dashboard("  unlock protective stop  "), (DashboardLine{DashboardCommand::UnlockProtectiveStop, ""}));
}

TEST(Dashboard, KeepsAnArgumentAsItWasWritten) {
  EXPECT_EQ(parse_dashboard("load Folder/My Program.urp"),
            (DashboardLine{DashboardCommand::Load, "Folder/My Program.urp"}));
  EXPECT_EQ(parse_dashboard("load"), (DashboardLine{DashboardCommand::Load, ""}));
  EXPECT_EQ(parse_dashboard("addToLog  A b "), (DashboardLine{DashboardCommand::AddToLog, "A b"}));
}

TEST(Dashboard, SaysWhatIsUnknown) {
  EXPECT_EQ(parse_dashboard("loadx"), (DashboardLine{DashboardCommand::Unknown, "loadx"}));
  EXPECT_EQ(parse_dashboard("play it"), (DashboardLine{DashboardCommand::Unknown, "play it"}));
  EXPECT_EQ(parse_dashboard(""), (DashboardLine{DashboardCommand::Unknown, ""}));
  EXPECT_EQ(parse_dashboard(std::string_view("\0\xff", 2)).command, DashboardCommand::Unknown);
}

}  // namespace
}  // namespace snug::ur
