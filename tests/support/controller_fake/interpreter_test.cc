// The fake's URScript: what programs compute, and where and how the controller refuses them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_fake/offline_run.h"

namespace sandwright::fake {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Interpreter : public ::testing::Test {
 protected:
  // `lines` within a program.
  void Run(const std::string& lines) {
    EXPECT_TRUE(RunToEnd(core_, "def program():\n" + lines + "end\n", 60));
  }
  std::string Fault() const { return core_.last_fault() ? core_.last_fault()->text : ""; }

  ControllerCore core_{ControllerFakeOptions{}};
};

TEST_F(Interpreter, Computes) {
  Run("  textmsg(1 + 2 * 3 - 4)\n"
      "  textmsg(7 / 2)\n"
      "  textmsg(-(2 - 5) % 2)\n"
      "  textmsg(not 1 > 2 and (True xor False))\n"
      "  textmsg(norm([3, 4, 0]))\n"
      "  q = [1, 2.5, 3]\n"
      "  q[1] = q[0] - 0.5e1\n"
      "  textmsg(\"q = \", q)\n"
      "  textmsg(pose_trans(p[1, 0, 0, 0, 0, 1.5707963267948966], p[0, 1, 0, 0, 0, 0])[0])\n");
  EXPECT_EQ(Fault(), "");
  EXPECT_THAT(core_.messages(), ElementsAre("3", "3.5", "1", "True", "5", "q = [1, -4, 3]", "0"));
}

TEST_F(Interpreter, ScopesAndCalls) {
  Run("  count = 0\n"
      "  global limit = 3\n"
      "  def add(p, amount):\n"
      "    local count = 100\n"
      "    count = count + 1\n"
      "    return p[0] + amount\n"
      "  end\n"
      "  def up():\n"
      "    count = count + 1\n"
      "  end\n"
      "  while True:\n"
      "    up()\n"
      "    if count >= limit:\n"
      "      break\n"
      "    elif count == 1:\n"
      "      continue\n"
      "    else:\n"
      "      textmsg(add([count], 0.5))\n"
      "    end\n"
      "  end\n"
      "  textmsg(count)\n");
  EXPECT_EQ(Fault(), "");
  EXPECT_THAT(core_.messages(), ElementsAre("2.5", "3"));
}

TEST_F(Interpreter, ThreadsTakeTurnsAndHaltEndsAll) {
  Run("  thread watch():\n"
      "    i = 0\n"
      "    while i < 5:\n"
      "      i = i + 1\n"
      "      write_output_integer_register(2, i)\n"
      "      sync()\n"
      "    end\n"
      "    textmsg(\"watch stops\")\n"
      "    halt\n"
      "  end\n"
      "  t = run watch()\n"
      "  while True:\n"
      "    sync()\n"
      "  end\n");
  EXPECT_THAT(core_.messages(), ElementsAre("watch stops"));
  EXPECT_EQ(core_.state().output_int[2], 5);
  EXPECT_EQ(Fault(), "");
  EXPECT_LT(core_.trace().size(), 8u);
}

TEST_F(Interpreter, HaltOfAThreadStopsAMovingArm) {
  Run("  thread watch():\n"
      "    sleep(0.5)\n"
      "    halt\n"
      "  end\n"
      "  run watch()\n"
      "  movej([0, -1.5, 1.5, 0, 0, 0], a=1.4, v=1)\n");
  EXPECT_EQ(Fault(), "");
  EXPECT_GT(core_.state().q[0], -1.8476 + 0.05);
  EXPECT_LT(core_.state().q[0], -1);
  EXPECT_EQ(core_.state().qd_radps.norm(), 0);
}

TEST_F(Interpreter, TwoThreadsCannotMoveTheArm) {
  Run("  thread other():\n"
      "    sleep(0.1)\n"
      "    stopj(4)\n"
      "  end\n"
      "  run other()\n"
      "  movej([0, -1.5, 1.5, 0, 0, 0])\n");
  EXPECT_THAT(Fault(), HasSubstr("another thread is already controlling the robot"));
}

TEST_F(Interpreter, KillFreesTheArm) {
  Run("  thread move():\n"
      "    movej([0, -1.5, 1.5, 0, 0, 0])\n"
      "  end\n"
      "  t = run move()\n"
      "  sleep(0.5)\n"
      "  kill t\n"
      "  stopj(8)\n"
      "  textmsg(norm(get_actual_joint_speeds()))\n");
  EXPECT_EQ(Fault(), "");
  EXPECT_THAT(core_.messages(), ElementsAre("0"));
}

TEST_F(Interpreter, UnknownFunctionFailsWhenItIsCalled) {
  Run("  if False:\n"
      "    tool_contact()\n"
      "  end\n"
      "  textmsg(\"before\")\n"
      "  x = 1 + zero_ftsensor()\n");
  EXPECT_THAT(core_.messages(), ElementsAre("before"));
  ASSERT_TRUE(core_.last_fault());
  EXPECT_EQ(core_.last_fault()->line, 6);
  EXPECT_EQ(core_.last_fault()->column, 11);
  EXPECT_THAT(Fault(), HasSubstr("zero_ftsensor"));
}

TEST_F(Interpreter, ListArithmeticIsRefused) {
  Run("  q = get_actual_joint_positions()\n  r = q * 2\n");
  EXPECT_THAT(Fault(), HasSubstr("unsupported operand types for *: list and int"));
}

TEST_F(Interpreter, LoopWithoutTimeIsRefused) {
  Run("  while True:\n  end\n");
  EXPECT_THAT(Fault(), HasSubstr("infinite loop"));
}

TEST_F(Interpreter, PopupWaitsForTheOperator) {
  Run("  popup(\"go?\", title=\"Sandwright\", warning=True, error=False, blocking=True)\n");
  EXPECT_NEAR(static_cast<double>(core_.trace().size()) * kControlPeriod_s, 0.2, 0.05);
}

TEST_F(Interpreter, WatchdogEndsAProgramThatIsNotFed) {
  Run("  rtde_set_watchdog(\"input_int_register_0\", 5, \"stop\")\n"
      "  while True:\n"
      "    sync()\n"
      "  end\n");
  EXPECT_NEAR(static_cast<double>(core_.trace().size()) * kControlPeriod_s, 0.2, 0.03);
}

TEST(ScriptLayout, RulesOfAnUpload) {
  const auto fault = [](const std::string& text) {
    ControllerCore core{ControllerFakeOptions{}};
    EXPECT_TRUE(RunToEnd(core, text, 10));
    return core.last_fault() ? std::to_string(core.last_fault()->line) + ": " +
                                   core.last_fault()->text
                             : "";
  };
  EXPECT_EQ(fault("def a():\n  sync()\nend\n"), "");
  EXPECT_THAT(fault("def a():\nsync()\nend\n"), HasSubstr("2: syntax error: line is not indented"));
  EXPECT_THAT(fault("def a():\n  if True:\nend\n"), HasSubstr("syntax error"));
  EXPECT_THAT(fault("def a():\n  x = = 2\nend\n"), HasSubstr("2: syntax error"));
  EXPECT_THAT(fault("def a():\n  x = \"open\nend\n"), HasSubstr("2: syntax error: string"));
  EXPECT_THAT(fault("def a():\n  # \xc3\xa4\n  sync()\nend\n"), HasSubstr("2: not extended ASCII"));
  EXPECT_THAT(fault("def a_name_that_is_longer_than_the_31():\n  sync()\nend\n"),
              HasSubstr("1: syntax error: program name"));
}

// As ur_rtde writes its program.
TEST(ScriptLayout, LenientControllersReadOnOverLineEnds) {
  const std::string text =
      "def a():\n"
      "  global offset = # number\n"
      "3  global other = 4\n"
      "  def f(p):\n"
      "    return\n"
      "  end\n"
      "  f(1) textmsg(offset + other)\n"
      "end\n";
  ControllerFakeOptions options;
  ControllerCore strict(options);
  EXPECT_TRUE(RunToEnd(strict, text, 10));
  EXPECT_TRUE(strict.last_fault());
  options.strict_scripts = false;
  ControllerCore lenient(options);
  EXPECT_TRUE(RunToEnd(lenient, text, 10));
  EXPECT_FALSE(lenient.last_fault());
  EXPECT_THAT(lenient.messages(), ElementsAre("7"));
}

TEST(ScriptLayout, ProgramsAreTakenOutOfAStream) {
  std::string received = "def a():\n  sync()\nen";
  EXPECT_TRUE(TakePrograms(received).empty());
  received += "d\nstopj(2)\ndef b():\n";
  EXPECT_THAT(TakePrograms(received), ElementsAre("def a():\n  sync()\nend\n", "stopj(2)\n"));
  EXPECT_EQ(received, "def b():\n");
}

}  // namespace
}  // namespace sandwright::fake
