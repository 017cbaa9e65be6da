/* SPDX-License-Identifier: MIT */
/* The functions of the programs, for the table (program_table.c). What each does is said there. */
#ifndef PROGRAM_PROGRAMS_H
#define PROGRAM_PROGRAMS_H

#include "program/program.h"

enum err run_prompt(const struct options *options, struct fault *fault);
enum err run_version(const struct options *options, struct fault *fault);
enum err run_script(const struct options *options, struct fault *fault);
enum err run_commands(const struct options *options, struct fault *fault);
enum err run_serve(const struct options *options, struct fault *fault);
enum err run_replay(const struct options *options, struct fault *fault);
enum err run_tutorial(const struct options *options, struct fault *fault);
enum err run_watch(const struct options *options, struct fault *fault);
enum err run_verify(const struct options *options, struct fault *fault);
enum err run_verify_bisect(const struct options *options, struct fault *fault);
enum err run_accept(const struct options *options, struct fault *fault);
enum err run_reseal(const struct options *options, struct fault *fault);
enum err run_diff(const struct options *options, struct fault *fault);
enum err run_apply(const struct options *options, struct fault *fault);
enum err run_log_procedure(const struct options *options, struct fault *fault);
enum err run_compare(const struct options *options, struct fault *fault);
enum err run_log(const struct options *options, struct fault *fault);
enum err run_log_script(const struct options *options, struct fault *fault);
enum err run_log_check(const struct options *options, struct fault *fault);
enum err run_log_anonymise(const struct options *options, struct fault *fault);
enum err run_log_repair(const struct options *options, struct fault *fault);
enum err run_show(const struct options *options, struct fault *fault);
enum err run_info(const struct options *options, struct fault *fault);
enum err run_help(const struct options *options, struct fault *fault);

#endif
