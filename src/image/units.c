/* SPDX-License-Identifier: MIT */
#include "image/units.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/choice.h"

double length_mm(const char *name)
{
    static const struct {
        const char *names;
        double mm;
    } unit[] = {
        {"pm|picometer|picometre|picometers|picometres", 1e-9},
        {"angstrom|angstroms|\xc3\x85|\xc3\xa5|\xe2\x84\xab|\\u00c5|\\u00e5", 1e-7},
        {"nm|nanometer|nanometre|nanometers|nanometres", 1e-6},
        {"um|micron|microns|micrometer|micrometre|micrometers|micrometres|\xb5m|\xc2\xb5m|"
         "\xce\xbcm|\\u00b5m|\\u03bcm",
         1e-3},
        {"mm|millimeter|millimetre|millimeters|millimetres", 1},
        {"cm|centimeter|centimetre|centimeters|centimetres", 10},
        {"dm|decimeter|decimetre|decimeters|decimetres", 100},
        {"m|meter|metre|meters|metres", 1e3},
        {"in|inch|inches", 25.4},
    };
    char small[24];
    const size_t length = strlen(name);
    if (length == 0 || length >= sizeof small)
        return 0;
    for (size_t i = 0; i <= length; i++)
        small[i] = name[i] >= 'A' && name[i] <= 'Z' ? (char)(name[i] - 'A' + 'a') : name[i];
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++)
        if (choice_find(unit[i].names, small) >= 0)
            return unit[i].mm;
    return 0;
}
