/* SPDX-License-Identifier: MIT */
/* Writes the transforms of this folder by ITK, and where ITK takes three places by each, in LPS:
 *
 *     c++ -std=c++17 -isystem /usr/include/ITK-5.2 make.cc -o make -lITKIOTransformBase-5.2 \
 *         -lITKIOTransformInsightLegacy-5.2 -lITKIOTransformMatlab-5.2 -lITKTransformFactory-5.2 \
 *         -lITKTransform-5.2 -lITKCommon-5.2 -litkvnl_algo-5.2 -litkvnl-5.2 -litksys-5.2
 *     ./make FOLDER */
#include <cstdio>
#include <fstream>
#include <string>

#include <itkAffineTransform.h>
#include <itkCompositeTransform.h>
#include <itkEuler3DTransform.h>
#include <itkMatlabTransformIOFactory.h>
#include <itkSimilarity3DTransform.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileWriter.h>
#include <itkTranslationTransform.h>
#include <itkTxtTransformIOFactory.h>
#include <itkVersorRigid3DTransform.h>

static std::string folder;
static std::ofstream places;

template <typename Value>
static void write(const char *name, const itk::Transform<Value, 3, 3> *transform)
{
    auto writer = itk::TransformFileWriterTemplate<Value>::New();
    writer->SetFileName(folder + "/" + name);
    writer->SetInput(transform);
    writer->Update();
    const double place[3][3] = {{0, 0, 0}, {31, -62.5, 47}, {-88, 104.25, -13}};
    for (const auto &p : place) {
        typename itk::Transform<Value, 3, 3>::InputPointType from;
        for (unsigned i = 0; i < 3; i++)
            from[i] = static_cast<Value>(p[i]);
        const auto to = transform->TransformPoint(from);
        char line[400];
        std::snprintf(line, sizeof line, "%s %.17g %.17g %.17g %.17g %.17g %.17g\n", name, p[0],
                      p[1], p[2], static_cast<double>(to[0]), static_cast<double>(to[1]),
                      static_cast<double>(to[2]));
        places << line;
    }
}

template <typename Transform> static typename Transform::Pointer of(std::initializer_list<double> p)
{
    auto out = Transform::New();
    typename Transform::ParametersType parameters(static_cast<unsigned>(p.size()));
    typename Transform::FixedParametersType fixed = out->GetFixedParameters();
    const double centre[3] = {12.5, -20, 33};
    for (unsigned i = 0; i < 3 && i < fixed.size(); i++)
        fixed[i] = centre[i];
    out->SetFixedParameters(fixed);
    unsigned at = 0;
    for (const double value : p)
        parameters[at++] = static_cast<typename Transform::ParametersValueType>(value);
    out->SetParameters(parameters);
    return out;
}

int main(int, char **arguments)
{
    folder = arguments[1];
    places.open(folder + "/places.txt");
    itk::TxtTransformIOFactory::RegisterOneFactory();
    itk::MatlabTransformIOFactory::RegisterOneFactory();
    itk::TransformFactoryBase::RegisterDefaultTransforms();
    auto affine = of<itk::AffineTransform<double, 3>>(
        {1.05, 0.1, -0.02, -0.08, 0.96, 0.04, 0.03, -0.05, 1.1, 4.5, -7.125, 1e-7});
    auto single = of<itk::AffineTransform<float, 3>>(
        {1.05, 0.1, -0.02, -0.08, 0.96, 0.04, 0.03, -0.05, 1.1, 4.5, -7.125, 11});
    auto base = of<itk::MatrixOffsetTransformBase<double, 3, 3>>(
        {0.9, 0.2, 0, -0.2, 0.9, 0.1, 0, -0.1, 1.2, -30, 7, 2});
    auto euler = of<itk::Euler3DTransform<double>>({0.3, -0.2, 0.5, 3, -40, 12});
    auto zyx = itk::Euler3DTransform<double>::New();
    auto rigid = of<itk::VersorRigid3DTransform<double>>({0.1, -0.25, 0.3, 5, 6, -70});
    auto similar = of<itk::Similarity3DTransform<double>>({-0.2, 0.15, 0.05, 8, -9, 10, 1.3});
    auto way = itk::TranslationTransform<double, 3>::New();
    auto parts = itk::CompositeTransform<double, 3>::New();
    zyx->SetComputeZYX(true);
    zyx->SetFixedParameters(zyx->GetFixedParameters());
    zyx->SetParameters(euler->GetParameters());
    itk::TranslationTransform<double, 3>::OutputVectorType offset;
    offset[0] = 11;
    offset[1] = -2.5;
    offset[2] = 7;
    way->Translate(offset);
    parts->AddTransform(rigid);
    parts->AddTransform(affine);
    parts->AddTransform(way);
    write<double>("affine.tfm", affine);
    write<double>("affine.mat", affine);
    write<float>("affine-float.mat", single);
    write<double>("base.mat", base);
    write<double>("base.txt", base);
    write<double>("euler.txt", euler);
    write<double>("euler-zyx.txt", zyx);
    write<double>("rigid.tfm", rigid);
    write<double>("similarity.txt", similar);
    write<double>("translation.tfm", way);
    write<double>("composite.txt", parts);
    return 0;
}
