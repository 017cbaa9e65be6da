/* Of the program, as `iftty --version`, pictures and records have it. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define PROGRAM_VERSION "0.1"

#endif
